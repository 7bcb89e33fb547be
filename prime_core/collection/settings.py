"""Settings of the collection."""

from pydantic import Field

from prime_core.configuration import Config, Count, Share, StepRange


class CollectionConfig(Config):
    """Settings of the collection."""

    episodes: int = Field(2250, ge=1, le=1_000_000)
    """Episodes in all (paper, PickPlace: 45 workers x 50)."""
    episodes_per_shard: Count = 5
    """Episodes that are kept, or lost on a kill, together."""
    draws_per_episode: int = Field(15, ge=1, le=10_000)
    """Primitives and runs of motor actions in an episode."""
    atomic_share: Share = 0.5
    """Share of draws that are runs of random motor actions."""
    atomic_steps: StepRange = (20, 60)
    """Least and greatest length of such a run."""
    attempts: int = Field(4, ge=1, le=10_000)
    """Parameter draws that are tried from one state until one succeeds, or the episode is given
    up (the release: 10)."""
    other_pairs: int = Field(60, ge=0, le=10_000)
    """Pairs of `other` drawn in each episode (paper: K)."""
    other_steps: StepRange = (5, 200)
    """Least and greatest length of such a pair: the parser's limits."""

    @property
    def shards(self) -> int:
        """Number of shards."""
        return -(-self.episodes // self.episodes_per_shard)

    def shard_episodes(self, shard: int) -> range:
        """Return the episodes of a shard."""
        first = shard * self.episodes_per_shard
        return range(first, min(first + self.episodes_per_shard, self.episodes))
