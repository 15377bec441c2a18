"""Results for people and programs: solutions with named channels, summaries, files, the command line."""
