"""A whole arm on servos: joint vectors to goals and back, each goal checked on its last step."""
