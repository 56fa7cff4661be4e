"""What a run keeps while it goes on: its account, its folder, the state of plugins, its history."""
