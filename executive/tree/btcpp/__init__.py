"""Trees in the XML of BehaviorTree.CPP 4, written and read."""
