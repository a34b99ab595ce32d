"""Webhooks: make, list, edit, remove, try out. `webhooks_queue` has what they are told, `webhooks_dispatch` sends."""

import secrets
from base64 import b64encode
from typing import Any

import httpcore
import httpx

from api import schemas
from api.services import auditing, webhooks_dispatch, webhooks_network, webhooks_queue
from api.services.access import Principal
from api.services.context import Context
from api.services.errors import ConflictError, NotFoundError, WebhookUrlError
from api.services.webhooks_sending import Result, Sender
from storage import deliveries, webhooks
from storage.database import ReadSession, WriteSession

MOST = 100
"""webhooks at most: every change of an alert looks at each"""
PORTS = {"https": 443, "http": 80}
TEST_TEXT = "This is a test; no alert has changed."


def add(context: Context, principal: Principal, draft: schemas.WebhookDraft) -> schemas.WebhookSecret:
    """Make a webhook and its secret."""
    check_url(draft.url, context.settings.webhook_allow_private)
    secret, now = new_secret(), context.clock()
    with context.database.write() as tx:
        if webhooks.count(tx) >= MOST:
            raise ConflictError(f"There are {MOST} webhooks, which is as many as there may be.")
        pk = webhooks.add(tx, draft.model_dump(), secret, principal.name, now)
        auditing.record(tx, principal, "webhook.create", target(pk), _told(draft.model_dump()), now)
        return schemas.WebhookSecret(webhook=present(_found(tx, pk)), secret=secret)


def find(context: Context, pk: int) -> schemas.Webhook:
    """Give a webhook."""
    with context.database.read() as tx:
        return present(_found(tx, pk))


def edit(context: Context, principal: Principal, pk: int, changes: dict[str, Any]) -> schemas.Webhook:
    """Change a webhook; what waits for another attempt is due at once when that may help."""
    if "url" in changes:
        check_url(changes["url"], context.settings.webhook_allow_private)
    now = context.clock()
    with context.database.write() as tx:
        _found(tx, pk)
        webhooks.change(tx, pk, changes)
        if "url" in changes or changes.get("active"):
            deliveries.hasten(tx, pk, now)
        auditing.record(tx, principal, "webhook.edit", target(pk), _told(changes), now)
        return present(_found(tx, pk))


def rotate_secret(context: Context, principal: Principal, pk: int) -> schemas.WebhookSecret:
    """Make a new secret; the former one signs nothing from now on."""
    secret, now = new_secret(), context.clock()
    with context.database.write() as tx:
        _found(tx, pk)
        webhooks.change(tx, pk, {"secret": secret})
        auditing.record(tx, principal, "webhook.rotate_secret", target(pk), None, now)
        return schemas.WebhookSecret(webhook=present(_found(tx, pk)), secret=secret)


def remove(context: Context, principal: Principal, pk: int) -> None:
    """Remove a webhook with its deliveries."""
    with context.database.write() as tx:
        if not webhooks.remove(tx, pk):
            raise _unknown()
        auditing.record(tx, principal, "webhook.remove", target(pk), None, context.clock())


def deliveries_page(context: Context, pk: int, limit: int, before: int | None) -> list[deliveries.Delivery]:
    """Give up to `limit` deliveries of a webhook, newest first."""
    with context.database.read() as tx:
        _found(tx, pk)
        return deliveries.page(tx, pk, limit, before)


def redeliver(context: Context, principal: Principal, pk: int) -> schemas.Redelivery:
    """Try anew what was given up."""
    now = context.clock()
    with context.database.write() as tx:
        _found(tx, pk)
        revived = deliveries.revive(tx, pk, now, now + webhooks_queue.SPAN)
        auditing.record(tx, principal, "webhook.redeliver", target(pk), {"deliveries": revived}, now)
        return schemas.Redelivery(deliveries=revived)


def test(context: Context, principal: Principal, pk: int) -> schemas.WebhookTest:
    """Call a webhook now and tell how that went; it is not tried again."""
    now = context.clock()
    with context.database.read() as tx:
        webhook = _found(tx, pk)
    data = {"webhook_id": pk, "message": TEST_TEXT}
    row = webhooks_queue.delivery(pk, webhooks_queue.TEST, webhooks_queue.message(webhooks_queue.TEST, data, now), now)
    with Sender(context.settings.webhook_allow_private) as sender:
        result = sender.send(webhook, row["message_id"], row["payload"], now)
    with context.database.write() as tx:
        if webhooks.find(tx, pk) is not None:
            _store_test(tx, row, result)
        auditing.record(tx, principal, "webhook.test", target(pk), {"delivered": result.delivered}, now)
    told = result._asdict()
    told.pop("retry_after")
    return schemas.WebhookTest(delivered=result.delivered, **told)


def _store_test(tx: WriteSession, row: dict[str, Any], result: Result) -> None:
    now = row["created_at"]
    if result.delivered:
        webhooks_dispatch.succeeded(tx, row["webhook_pk"], now)
    state = deliveries.DELIVERED if result.delivered else deliveries.FAILED
    ended = {"state": state, "attempts": 1, "next_attempt_at": None, "last_attempt_at": now}
    told = {"last_status": result.status, "last_error": result.error, "duration_ms": result.duration_ms}
    deliveries.add(tx, [row | ended | told])


def backlog(tx: ReadSession) -> int:
    """Count the deliveries that are still to be made."""
    return deliveries.backlog(tx)


def check_url(text: str, allow_private: bool) -> None:
    """Refuse what may not be called; a name that cannot be resolved now may be later."""
    try:
        url = httpx.URL(text)
    except (httpx.InvalidURL, ValueError) as error:
        raise WebhookUrlError("This is not a URL.") from error
    allowed = ("https", "http") if allow_private else ("https",)
    if url.scheme not in allowed or not url.raw_host:
        raise WebhookUrlError(f"The URL has to begin with {' or '.join(f'{scheme}://' for scheme in allowed)}.")
    if not 0 < (url.port or PORTS[url.scheme]) < 65536:
        raise WebhookUrlError("The port is not one.")
    if url.userinfo or url.fragment:
        raise WebhookUrlError("The URL may hold no user, no password and no fragment.")
    _check_address(url, allow_private)


def _check_address(url: httpx.URL, allow_private: bool) -> None:
    try:
        webhooks_network.resolve(url.raw_host.decode(), url.port or PORTS[url.scheme], allow_private)
    except webhooks_network.RefusedAddressError as error:
        raise WebhookUrlError("Webhooks call only addresses of the public internet.") from error
    except httpcore.ConnectError:
        return


def new_secret() -> str:
    """Make a secret as the libraries of Standard Webhooks take it."""
    return f"whsec_{b64encode(secrets.token_bytes(32)).decode()}"


def present(row: webhooks.Webhook) -> schemas.Webhook:
    """Give a webhook as a document."""
    shown = row._asdict()
    return schemas.Webhook(id=shown.pop("pk"), **{name: shown[name] for name in shown if name != "secret"})


def present_delivery(row: deliveries.Delivery) -> schemas.WebhookDelivery:
    """Give a delivery as a document."""
    shown = row._asdict() | {"id": row.pk}
    return schemas.WebhookDelivery.model_validate({name: shown[name] for name in schemas.WebhookDelivery.model_fields})


def target(pk: int) -> str:
    """Give the path of a webhook, as the audit trail has it."""
    return f"webhooks/{pk}"


def _told(values: dict[str, Any]) -> dict[str, Any]:
    """Give what the audit trail tells: of a URL only where it leads, since the rest is often a secret."""
    if "url" not in values:
        return values
    url = httpx.URL(values["url"])
    return values | {"url": f"{url.scheme}://{url.netloc.decode()}"}


def _found(tx: ReadSession, pk: int) -> webhooks.Webhook:
    row = webhooks.find(tx, pk)
    if row is None:
        raise _unknown()
    return row


def _unknown() -> NotFoundError:
    return NotFoundError("There is no such webhook.")
