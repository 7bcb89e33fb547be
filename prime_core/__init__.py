"""prime: robot imitation learning with behaviour primitives."""
