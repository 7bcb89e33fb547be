"""LeRobot's own policies as policies over motor actions: ``lerobot/act`` and ``lerobot/diffusion``.

Networks, losses, action queues and normalisation are LeRobot's classes; windows, checkpoints and
the training loop are ours (`prime_policies.motor`, `prime_policies.training`). `settings` has what
can be set, under LeRobot's names, `config` what is registered, `designs` makes LeRobot's policies,
`network` trains and asks them, `statistics` tells LeRobot what to normalise by, and `policy` is a
policy at work. Another policy of LeRobot's is settings and a design more.

The package ``lerobot`` is optional; it is imported by `designs` and `network` alone.
"""
