"""The only reader and writer of Blender data: whole arrays in, whole arrays out."""
