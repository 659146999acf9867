// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

// Empty: it is there to precompile the headers that the tests share.
