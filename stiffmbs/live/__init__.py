"""Live page: a scene that is solved again after every change, in a browser on the same machine (extra ``live``)."""
