"""Commands of ``stiffmbs``, one file each."""
