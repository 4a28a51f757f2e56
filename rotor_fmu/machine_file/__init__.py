"""Machine files: reading a user's; what one may say, made from the quantities, as a page and as
a schema for editors."""
