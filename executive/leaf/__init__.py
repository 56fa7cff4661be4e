"""What leaves are made of: ports, typed access to plugins, jobs, and steps that several leaves
share.
"""
