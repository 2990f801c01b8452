"""From scans and a design to `Results`: the gear as measured, what each effect contributed, its wear, and the pair that runs with it."""
