"""The Groot2 protocol: monitors of BehaviorTree.CPP show a running mission."""
