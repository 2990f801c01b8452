"""The second closed loop: from the pattern of the wear to how the pair ran. What the wear law lacks is named, and the error told before and after."""
