"""The scale of a sensor's noise as it was known before an alarm."""


class CalmScale:
    """Keeps the scale of before an alarm for some time, so that the alarm does not explain itself.

    A prediction that is wrong makes innovations large, and what is taken for noise grows with
    them. A sensor that has really become noisier is believed after that time.
    """

    def __init__(self, kept_s: float, factor: float = 1.0) -> None:
        """Begin without an alarm.

        Args:
            kept_s: How long a scale is kept [s].
            factor: The scale at first.
        """
        self._kept_s, self._factor, self._calm_s = kept_s, factor, -float("inf")

    def factor(self, now_s: float, is_alarmed: bool, newest: float) -> float:
        """Return the factor on the declared variance that is known.

        Args:
            now_s: The time [s].
            is_alarmed: Whether there is an alarm.
            newest: The factor by the newest innovations.
        """
        if not is_alarmed or now_s - self._calm_s > self._kept_s:
            self._factor = newest
            self._calm_s = now_s if not is_alarmed else self._calm_s
        return self._factor
