"""Two gears in mesh under load: elastic teeth, load sharing, loaded transmission error, mesh stiffness and pressure."""
