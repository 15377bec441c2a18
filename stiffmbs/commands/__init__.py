"""The commands of ``stiffmbs``, one file each."""
