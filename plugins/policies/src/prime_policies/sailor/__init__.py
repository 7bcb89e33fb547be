"""The policy ``sailor``: skills of the rollouts, and a policy that says which one comes next.

After Nasiriany et al. 2022. The three parts of a training are told apart by their modules: the
skills (`skill_model`, `skill_examples`), what is found again of the rollouts (`retrieval`), and
the policy (`latent_policy`, `latent_examples`). `fitting` does one after the other; `policy` is
what acts. Windows of episodes and the ranges of what is seen and done are those of
`prime_policies.motor`.
"""
