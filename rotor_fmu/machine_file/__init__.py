"""Machine files: reading a user's file; its tables and keys, made from the quantities, as a page
and as a schema for editors."""
