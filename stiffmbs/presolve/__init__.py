"""What is solved for in place of the whole model: merged bodies, subsystems, constant coordinates."""
