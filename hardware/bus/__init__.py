"""The bus that servos hang on: what every bus does, the real one, and its packets as bytes."""
