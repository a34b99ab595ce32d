"""Webhooks."""

from typing import Annotated

from fastapi import APIRouter, Depends, Path

from api import schemas
from api.dependencies import BeforeNumber, CurrentContext, Limit, Manager, Requires
from api.services import paging, webhooks
from api.services.access import Role
from storage import webhooks as stored

router = APIRouter(prefix="/webhooks", tags=["webhooks"], dependencies=[Depends(Requires(Role.MANAGER))])

Number = Annotated[int, Path(ge=1, le=2**63 - 1)]


@router.post("", status_code=201)
def add_webhook(draft: schemas.WebhookDraft, principal: Manager, context: CurrentContext) -> schemas.WebhookSecret:
    """Make a webhook. Its secret is shown only in this answer."""
    return webhooks.add(context, principal, draft)


@router.get("")
def list_webhooks(context: CurrentContext, before: BeforeNumber, limit: Limit = 100) -> schemas.Page[schemas.Webhook]:
    """List webhooks, newest first."""
    with context.database.read() as tx:
        rows = stored.page(tx, limit + 1, before)
    return paging.page(rows, limit, lambda row: row.pk, webhooks.present)


@router.get("/{webhook_id}")
def read_webhook(webhook_id: Number, context: CurrentContext) -> schemas.Webhook:
    """Read a webhook."""
    return webhooks.find(context, webhook_id)


@router.patch("/{webhook_id}")
def edit_webhook(
    webhook_id: Number, patch: schemas.WebhookPatch, principal: Manager, context: CurrentContext
) -> schemas.Webhook:
    """Change a webhook; what is left out stays."""
    return webhooks.edit(context, principal, webhook_id, patch.model_dump(exclude_unset=True))


@router.delete("/{webhook_id}", status_code=204)
def remove_webhook(webhook_id: Number, principal: Manager, context: CurrentContext) -> None:
    """Remove a webhook with its deliveries."""
    webhooks.remove(context, principal, webhook_id)


@router.post("/{webhook_id}/secret")
def rotate_webhook_secret(webhook_id: Number, principal: Manager, context: CurrentContext) -> schemas.WebhookSecret:
    """Make a new secret, shown only in this answer; the former one signs nothing from now on."""
    return webhooks.rotate_secret(context, principal, webhook_id)


@router.get("/{webhook_id}/deliveries")
def list_webhook_deliveries(
    webhook_id: Number, context: CurrentContext, before: BeforeNumber, limit: Limit = 100
) -> schemas.Page[schemas.WebhookDelivery]:
    """List what was sent or waits to be sent, newest first."""
    rows = webhooks.deliveries_page(context, webhook_id, limit + 1, before)
    return paging.page(rows, limit, lambda row: row.pk, webhooks.present_delivery)


@router.post("/{webhook_id}/redeliver")
def redeliver_webhook(webhook_id: Number, principal: Manager, context: CurrentContext) -> schemas.Redelivery:
    """Try anew what was given up."""
    return webhooks.redeliver(context, principal, webhook_id)


@router.post("/{webhook_id}/test")
def test_webhook(webhook_id: Number, principal: Manager, context: CurrentContext) -> schemas.WebhookTest:
    """Call the webhook now with a message of type `test` and tell how that went."""
    return webhooks.test(context, principal, webhook_id)
