"""Feedback on the answers to each chapter's exercises: one module per chapter."""
