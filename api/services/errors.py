"""What a service refuses to do, as values of one family; `api/errors.py` says which HTTP status each becomes."""

UNKNOWN_DEVICE = "There is no such device."


class ServiceError(Exception):
    """Base: `detail` is a sentence for the caller, `kind` the last part of the problem's type."""

    kind = "error"
    title = "The request was refused"

    def __init__(self, detail: str) -> None:
        super().__init__(detail)
        self.detail = detail


class UnauthenticatedError(ServiceError):
    """No key, or one that is not known."""

    kind = "unauthenticated"
    title = "A valid key is needed"


class ForbiddenError(ServiceError):
    """The key does not allow this."""

    kind = "forbidden"
    title = "The key does not allow this"


class NotFoundError(ServiceError):
    """There is no such thing."""

    kind = "not-found"
    title = "Not found"


class ConflictError(ServiceError):
    """It is taken, or contradicts what is stored."""

    kind = "conflict"
    title = "The request contradicts what is stored"


class ChunkConflictError(ConflictError):
    """Other bytes came in under this session and number before."""

    kind = "chunk-conflict"
    title = "Another chunk has this number"


class SequencePassedError(ConflictError):
    """The gap this chunk would have filled was declared lost, and time went on."""

    kind = "sequence-passed"
    title = "The chunk comes too late"


class SessionEndedError(ConflictError):
    """A newer session of the device has begun; this chunk would run time backwards."""

    kind = "session-ended"
    title = "The session has ended"


class NotStillError(ConflictError):
    """The vehicle is not standing still, as far as the device has told."""

    kind = "not-still"
    title = "The vehicle is not standing still"


class SeveralSessionsError(ConflictError):
    """Samples of several sessions do not fit into one log."""

    kind = "several-sessions"
    title = "There are several sessions"


class LongSpanError(ServiceError):
    """More than is computed at once."""

    kind = "span-too-long"
    title = "The span is too long"


class UnusableError(ServiceError):
    """The samples cannot be used."""

    kind = "unusable-samples"
    title = "The samples cannot be used"


class WebhookUrlError(ServiceError):
    """A webhook may not call this address."""

    kind = "webhook-url"
    title = "The URL cannot be called"


class CursorError(ServiceError):
    """A cursor this service did not give."""

    kind = "invalid-cursor"
    title = "The cursor is not valid"


class TooLargeError(ServiceError):
    """More bytes than are taken."""

    kind = "too-large"
    title = "The chunk is too large"


class TooManyRequestsError(ServiceError):
    """More calls than are allowed; `retry_after`, s, says when to try again."""

    kind = "too-many-requests"
    title = "Too many requests"

    def __init__(self, detail: str, retry_after: int) -> None:
        super().__init__(detail)
        self.retry_after = retry_after


class LastAdminError(ConflictError):
    """Nobody could administer the service any more."""

    kind = "last-admin-key"
    title = "This is the last admin key"


class ExpiryError(ServiceError):
    """A key would have expired before it was made."""

    kind = "expiry-passed"
    title = "The key would have expired already"


class StartingError(ServiceError):
    """Not ready yet."""

    kind = "starting"
    title = "The service is starting"
