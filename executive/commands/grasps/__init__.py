"""The verb that plans how to hold a stone of a cloud."""
