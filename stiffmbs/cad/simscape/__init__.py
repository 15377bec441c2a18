"""Simscape Multibody XML, which SolidWorks, Creo, Inventor and Onshape export."""
