"""What a machine file may say, made from the quantities: a page, and a schema for editors."""
