"""Tables that Python and compiled code share (`stiffmbs.compile.machine.layout`)."""
