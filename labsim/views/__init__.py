"""Pictures: one module per chapter. A view builds its axes once and then only moves its artists."""
