import { MantineProvider } from "@mantine/core";
import { QueryClientProvider } from "@tanstack/react-query";
import { type ComponentType, Suspense } from "react";
import { Redirect, Route, Switch } from "wouter";
import { client } from "../api/client";
import { atLeast, useSession } from "../api/session";
import type { Role, SignedIn } from "../api/types";
import { Failed, Loading } from "../components/States";
import { t, useLanguage } from "../text";
import { ErrorBoundary } from "./ErrorBoundary";
import { LiveProvider } from "./Live";
import { NotFound } from "./NotFound";
import { AlertsPage, DevicePage, DevicesPage, EventPage, MotionPage, SettingsPage } from "./pages";
import { Shell } from "./Shell";
import { SignIn } from "./SignIn";
import { useScroll } from "./scroll";
import { theme } from "./theme";

/** Another language is another page: everything is drawn anew. */
export function App() {
  const language = useLanguage();
  return (
    <MantineProvider
      theme={theme}
      defaultColorScheme="auto"
      withCssVariables={false}
      withGlobalClasses={false}
    >
      <QueryClientProvider client={client}>
        <ErrorBoundary key={language}>
          <Gate />
        </ErrorBoundary>
      </QueryClientProvider>
    </MantineProvider>
  );
}

function Gate() {
  const session = useSession();
  if (session.isPending) return <Loading what="Livella" lines={1} />;
  if (session.isError) return <Failed what="Livella" error={session.error} retry={session.refetch} />;
  if (session.data === null) return <SignIn />;
  return (
    <LiveProvider>
      <Shell session={session.data}>
        <Suspense fallback={<Loading what={t("shell.this_page")} lines={8} />}>
          <Pages session={session.data} />
        </Suspense>
      </Shell>
    </LiveProvider>
  );
}

/** A device's key sees its own device and nothing else. */
function Pages({ session }: { session: SignedIn }) {
  useScroll();
  const own = session.device_id;
  const home = own === null ? "/devices" : `/devices/${encodeURIComponent(own)}`;
  const allowed = (needed: Role, Page: ComponentType) =>
    own === null && atLeast(session.role, needed) ? <Page /> : <Redirect to={home} replace />;
  return (
    <Switch>
      <Route path="/">
        <Redirect to={home} replace />
      </Route>
      <Route path="/devices">{allowed("installer", DevicesPage)}</Route>
      <Route path="/devices/:id">{({ id }) => <DevicePage key={id} id={id} />}</Route>
      <Route path="/devices/:id/motion">{({ id }) => <MotionPage key={id} id={id} />}</Route>
      <Route path="/devices/:id/motion/:event">
        {({ id, event }) => <EventPage key={event} id={id} event={Number(event)} />}
      </Route>
      <Route path="/alerts">{allowed("manager", AlertsPage)}</Route>
      <Route path="/settings/*?">{allowed("installer", SettingsPage)}</Route>
      <Route>
        <NotFound title={t("shell.nowhere")} />
      </Route>
    </Switch>
  );
}
