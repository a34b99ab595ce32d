"""Where `limits` counts: its own storage starts a thread for every few calls, and has no bound."""

import threading
import time
from collections import OrderedDict

from limits.storage import Storage
from limits.storage.base import SlidingWindowCounterSupport

MOST = 100_000
"""keys and addresses that are counted at once; the one that was silent longest is forgotten"""


class Counts(Storage, SlidingWindowCounterSupport):
    """For each key the number of its window, the count in the window before and the count in it."""

    STORAGE_SCHEME = None

    def __init__(self, most: int = MOST) -> None:
        super().__init__()
        self.most = most
        self._counts: OrderedDict[str, tuple[int, int, int]] = OrderedDict()
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._counts)

    @property
    def base_exceptions(self) -> type[Exception]:
        """What may go wrong."""
        return ValueError

    def acquire_sliding_window_entry(self, key: str, limit: int, expiry: int, amount: int = 1) -> bool:
        """Count a call if it is allowed."""
        with self._lock:
            window, share, before, now = self._look(key, expiry)
            if int(before * share + now) + amount > limit:
                return False
            self._put(key, (window, before, now + amount))
            return True

    def get_sliding_window(self, key: str, expiry: int) -> tuple[int, float, int, float]:
        """Give count and seconds left, of the window before and of the one now."""
        with self._lock:
            _, share, before, now = self._look(key, expiry)
        return before, share * expiry, now, (share + 1.0) * expiry

    def clear_sliding_window(self, key: str, expiry: int) -> None:
        """Forget a key."""
        self.clear(key)

    def incr(self, key: str, expiry: int, amount: int = 1) -> int:
        """Count a call in any case."""
        with self._lock:
            window, _, before, now = self._look(key, expiry)
            self._put(key, (window, before, now + amount))
        return now + amount

    def get(self, key: str) -> int:
        """Give the count of the last window in which there was a call."""
        return self._counts.get(key, (0, 0, 0))[2]

    def get_expiry(self, key: str) -> float:
        """Tell when a key is forgotten: not by the clock, see `MOST`."""
        return time.time()

    def check(self) -> bool:
        """Tell that the storage is there."""
        return True

    def reset(self) -> int:
        """Forget everything; tell how much that was."""
        with self._lock:
            known = len(self._counts)
            self._counts.clear()
        return known

    def clear(self, key: str) -> None:
        """Forget a key."""
        with self._lock:
            self._counts.pop(key, None)

    def _put(self, key: str, counted: tuple[int, int, int]) -> None:
        self._counts[key] = counted
        self._counts.move_to_end(key)
        if len(self._counts) > self.most:
            self._counts.popitem(last=False)

    def _look(self, key: str, expiry: int) -> tuple[int, float, int, int]:
        """Give the number of the window, the share of the one before that still counts, and both counts."""
        moment = time.time() / expiry
        window = int(moment)
        known, before, now = self._counts.get(key, (window, 0, 0))
        if known != window:
            before, now = (now if known == window - 1 else 0), 0
        return window, 1.0 - moment % 1.0, before, now
