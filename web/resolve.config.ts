import { defaultClientConditions, defaultServerConditions } from 'vite';

const CONDITION = 'haptolith-source';

// The sources of the protocol's package, for the page and for programs in tests/: no build is required first.
export const protocolSource = {
  resolve: { conditions: [CONDITION, ...defaultClientConditions] },
  ssr: { resolve: { conditions: [CONDITION, ...defaultServerConditions] } },
};
