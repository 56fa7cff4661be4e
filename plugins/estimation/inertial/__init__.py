"""Inertial mechanisation: the state, its noise, and the samples it is made from."""
