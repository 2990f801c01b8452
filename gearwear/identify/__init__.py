"""A gear without a design: what a scan by itself says of axis, teeth and dimensions, and the design that it proposes."""
