"""The supervisor while a run is made: node processes, recorder loop, values of this moment, state of the machine."""
