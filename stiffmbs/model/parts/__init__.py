"""Parts: reusable definitions that scenes place and mirror."""
