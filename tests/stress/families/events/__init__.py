"""Events in the state: contacts, stops, friction, and motions that come to no end."""
