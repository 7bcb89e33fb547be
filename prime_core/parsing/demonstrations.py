"""Parses demonstrations with an inverse dynamics model and a parser."""

import numpy as np

from prime_core.contracts.calls import OTHER, PrimitiveCall
from prime_core.contracts.demonstration import Demonstration, ParsedDemonstration, Segment
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.parser import ParserConfig
from prime_core.parsing.confidence import segment_confidences
from prime_core.parsing.scores import score_pairs


def parse_demonstration(
    demonstration: Demonstration, idm: InverseDynamicsModel, config: ParserConfig
) -> ParsedDemonstration:
    """Cut a demonstration into primitive calls.

    Args:
        demonstration: What to cut.
        idm: What to explain the pieces with.
        config: Which parser.

    Returns:
        The demonstration with its segments.
    """
    features = idm.encode(demonstration.observations.only(idm.sees))
    scores = score_pairs(idm, features, config)
    parsed = config.build().parse(scores)
    segments = []
    for item, confidence in zip(parsed, segment_confidences(scores, parsed), strict=True):
        if item.label == len(idm.space.names):
            call = PrimitiveCall(OTHER, np.empty(0))
        else:
            pair = np.array([[item.start, item.end]])
            values, _ = idm.parameters(features, pair, np.array([item.label]))
            width = len(idm.space.parameter_spaces[item.label])
            call = PrimitiveCall(idm.space.names[item.label], values[0, :width])
        segments.append(Segment(item.start, item.end, call, item.log_probability, confidence))
    return ParsedDemonstration(demonstration, tuple(segments))
