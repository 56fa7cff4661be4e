"""Segmentation by geometry and convexity: piles and touching stones."""

from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters, Splitter
from executive_plugins.segmentation.limits import Limits
from executive_plugins.segmentation.settings import GroundAndPartsSettings


class GroundAndParts(GroundAndClusters):
    """Ground and clusters, each cluster split along its concave borders."""

    Settings = GroundAndPartsSettings
    latency_s = {"segment": 0.3}

    def _splitter(self, limits: Limits) -> Splitter:
        return self._by_convexity(limits)
