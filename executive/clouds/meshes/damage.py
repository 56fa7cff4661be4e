"""What is wrong with the content of a mesh file."""


class MeshDamageError(Exception):
    """The content cannot be a mesh; the reader adds the file and the cure."""
