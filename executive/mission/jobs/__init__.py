"""Long verbs outside of the tick: jobs, the runners that compute them, and worker processes."""
