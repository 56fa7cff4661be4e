"""What the kit calls of each capability, with which inputs: ordinary ones and hostile ones."""
