"""What the simulated world and the planners that rehearse in physics share: stone shapes and
contact.
"""
