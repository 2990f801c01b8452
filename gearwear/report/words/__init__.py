"""What the report says in words: terminal, verdict, effects."""
