import { MantineProvider } from "@mantine/core";
import { QueryCache, QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { Redirect, Route, Switch } from "wouter";
import { Problem } from "../api/http";
import { keys } from "../api/keys";
import { useSession } from "../api/session";
import type { SignedIn } from "../api/types";
import { Failed, Loading } from "../components/States";
import { DevicePage } from "../device/DevicePage";
import { DevicesPage } from "../devices/DevicesPage";
import { ErrorBoundary } from "./ErrorBoundary";
import { LiveProvider } from "./Live";
import { NotFound } from "./NotFound";
import { Shell } from "./Shell";
import { SignIn } from "./SignIn";
import { theme } from "./theme";

/** A refusal (4xx) is an answer; only silence and the service's own trouble are worth another try. */
function worthRetrying(count: number, error: Error): boolean {
  return count < 3 && !(error instanceof Problem && error.status >= 400 && error.status < 500);
}

const client: QueryClient = new QueryClient({
  defaultOptions: { queries: { retry: worthRetrying, staleTime: 30_000, refetchOnWindowFocus: false } },
  queryCache: new QueryCache({ onError: signedOut }),
});

/** The session ended while the page was open: back to the sign-in. */
function signedOut(error: Error): void {
  if (error instanceof Problem && error.status === 401) client.setQueryData(keys.session, null);
}

export function App() {
  return (
    <MantineProvider
      theme={theme}
      defaultColorScheme="auto"
      withCssVariables={false}
      withGlobalClasses={false}
    >
      <QueryClientProvider client={client}>
        <ErrorBoundary>
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
        <Pages session={session.data} />
      </Shell>
    </LiveProvider>
  );
}

/** A device's key sees its own device and nothing else. */
function Pages({ session }: { session: SignedIn }) {
  const home = session.device_id && `/devices/${encodeURIComponent(session.device_id)}`;
  return (
    <Switch>
      <Route path="/">{home ? <Redirect to={home} replace /> : <Redirect to="/devices" replace />}</Route>
      <Route path="/devices">{home ? <Redirect to={home} replace /> : <DevicesPage />}</Route>
      <Route path="/devices/:id">{({ id }) => <DevicePage key={id} id={id} />}</Route>
      <Route>
        <NotFound what="This page" />
      </Route>
    </Switch>
  );
}
