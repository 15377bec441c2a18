"""Parts: what is written once and stands in a scene several times, placed and mirrored."""
