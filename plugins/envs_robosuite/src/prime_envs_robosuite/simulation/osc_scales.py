"""What robosuite's OSC_POSE controller at 20 Hz makes of an action.

These numbers are compiled into the cached code of control_law.py, which does not notice that they
change: empty its __pycache__ after a change here, in c_call.py or in control_memory.py.
"""

POSITION_SCALE = 0.05  # metres at an action of 1
ROTATION_SCALE = 0.5  # radians at an action of 1
GRIPPER_SPEED = 0.2  # share of half a stroke per control step
