"""Files that no instrument writes: made on purpose, and by structured chance."""
