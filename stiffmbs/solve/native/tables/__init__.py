"""Tables shared by Python and compiled code (`stiffmbs.compile.machine.layout`)."""
