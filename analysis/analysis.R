#!/usr/bin/env Rscript
# Reproduces the numbers of `haptolith study figure` from an export of the study, and fits mixed models for comparison.
#
#     Rscript friction-analysis.R                  reads friction.csv next to it
#     Rscript analysis.R FOLDER                    a BIDS export
#     Rscript analysis.R friction.csv --no-glmm    without the mixed models, which need lme4
#
# Model: see the docstring of analysis.py, and docs/reference/psychometrics.md.

WIDTH <- 3.289707253902943 # from 5 % to 95 % of a normal distribution, in standard deviations
PLACES <- 61               # grid points of a person's table, per axis
COARSE <- c(11, 6, 11, 6, 6)
FINE <- c(19, 11, 19, 11, 9)
USUAL_LOG_SPREAD <- 0.6
LAPSE_PRIOR <- 100
CONFIDENCE <- 0.95

# --- data ---------------------------------------------------------------------------------------------------------------

read_trials <- function(path) {
  if (!dir.exists(path)) return(read.csv(path, stringsAsFactors = FALSE))
  people <- read.delim(file.path(path, "participants.tsv"), stringsAsFactors = FALSE)
  tables <- sort(Sys.glob(file.path(path, "sub-*", "beh", "*_beh.tsv")))
  do.call(rbind, lapply(tables, function(table) {
    trials <- read.delim(table, stringsAsFactors = FALSE, na.strings = "n/a")
    trials$participant <- sub("^sub-([^_]+)_.*", "\\1", basename(table))
    trials$block <- sub(".*_task-([^_]+)_beh.*", "\\1", basename(table))
    trials$kind <- trials$trial_type
    state <- people$state[match(paste0("sub-", trials$participant), people$participant_id)]
    trials$participant_state <- if (is.null(state)) "" else state
    group <- people$group[match(paste0("sub-", trials$participant), people$participant_id)]
    trials$group <- if (is.null(group)) "" else group
    trials[c("participant", "block", "kind", "state", "response", "x", "x_reference", "participant_state", "group")]
  }))
}

# Analysed responses, without participants who have withdrawn or been excluded.
counted <- function(trials) {
  trials <- trials[trials$kind == "main" & trials$state == "answered" & trials$response %in% c(0, 1) &
                     !(trials$participant_state %in% c("withdrawn", "excluded")), ]
  trials$response <- as.integer(trials$response)
  # Each group of a study is fitted separately.
  group <- if (is.null(trials$group)) rep("", nrow(trials)) else trials$group
  trials$block <- ifelse(group %in% c("", NA), trials$block, paste(trials$block, "of group", group))
  trials
}

# --- the model ----------------------------------------------------------------------------------------------------------

priors_of <- function(x) {
  places <- sort(unique(log(x)))
  range <- diff(range(places))
  least <- min(diff(places))
  list(first = places[1], last = places[length(places)], range = range,
       supports = rbind(c(places[1] - range / 2, places[length(places)] + range / 2), c(0, range),
                        log(expm1(c(least / 4, 3 * range) / WIDTH)), c(0, 4 * USUAL_LOG_SPREAD), c(0, 0.5)))
}

log_place_prior <- function(priors, t) {
  outside <- pmax(priors$first - t, t - priors$last, 0)
  log(pmax((1 + cos(pi * pmin(outside / (priors$range / 2), 1))) / 2, 1e-300))
}

log_priors <- function(priors, grids) {
  list(log_place_prior(priors, grids[[1]]), -(grids[[2]] / (priors$range / 4))^2 / 2, 0 * grids[[3]],
       -(grids[[4]] / USUAL_LOG_SPREAD)^2 / 2, (LAPSE_PRIOR - 1) * log1p(-grids[[5]]))
}

# Log-likelihood of one person's responses over thresholds t (rows) and ln w (columns).
log_likelihood <- function(person, t, u, lapse) {
  total <- matrix(0, length(t), length(u))
  for (i in seq_along(person$x)) {
    z <- outer(log(person$x[i]) - t, log1p(exp(u)), "/")
    k <- person$k[i]
    rest <- person$n[i] - k
    if (lapse == 0) {
      total <- total + k * pnorm(z, log.p = TRUE) + rest * pnorm(-z, log.p = TRUE)
    } else {
      psi <- lapse + (1 - 2 * lapse) * pnorm(z)
      total <- total + k * log(psi) + rest * log1p(-psi)
    }
  }
  total
}

span <- function(support, size) seq(support[1], support[2], length.out = size)

# Range of the kept values, extended by one value on each side.
around <- function(values, kept) {
  at <- which(kept)
  values[c(max(at[1] - 1, 1), min(at[length(at)] + 1, length(values)))]
}

table_of <- function(person, priors, lapses) {
  place <- priors$supports[1, ]
  log_w <- priors$supports[3, ]
  for (round in 1:2) {
    t <- span(place, PLACES)
    u <- span(log_w, PLACES)
    kept <- matrix(FALSE, PLACES, PLACES)
    for (lapse in lapses) {
      log <- log_likelihood(person, t, u, lapse)
      kept <- kept | log >= max(log) - 12
    }
    place <- around(t, rowSums(kept) > 0)
    log_w <- around(u, colSums(kept) > 0)
  }
  list(t = span(place, PLACES), u = span(log_w, PLACES))
}

# Weights of `values` for the means over normal distributions (rows; means vary fastest) of a function that is linear
# between the values.
normal_weights <- function(means, spreads, values) {
  mean <- rep(means, times = length(spreads))
  spread <- pmax(rep(spreads, each = length(means)), 1e-12)
  away <- outer(-mean, values, "+")
  z <- away / spread
  integral <- away * pnorm(z) + spread * dnorm(z)
  slopes <- (integral[, -1] - integral[, -length(values)]) / (values[2] - values[1])
  slopes <- cbind(0, slopes, 1)
  slopes[, -1] - slopes[, -ncol(slopes)]
}

trapezoid <- function(values) {
  halves <- diff(values) / 2
  c(halves, 0) + c(0, halves)
}

# Log posterior density over mean and SD of t, mean and SD of ln w, and the lapse rate.
posterior_on <- function(people, tables, priors, supports, sizes) {
  grids <- lapply(1:5, function(i) span(supports[i, ], sizes[i]))
  share <- seq(0, 1, length.out = sizes[5])^(if (supports[5, 1] > 0) 1 else 2)
  grids[[5]] <- supports[5, 1] + diff(supports[5, ]) * share
  logs <- log_priors(priors, grids)
  density <- array(Reduce(function(a, b) outer(a, b, "+"), logs), sizes)
  for (i in seq_along(people)) {
    of_t <- normal_weights(grids[[1]], grids[[2]], tables[[i]]$t)
    of_u <- normal_weights(grids[[3]], grids[[4]], tables[[i]]$u)
    likelihoods <- lapply(grids[[5]], function(lapse) log_likelihood(people[[i]], tables[[i]]$t, tables[[i]]$u, lapse))
    most <- max(unlist(likelihoods))
    for (c in seq_along(likelihoods)) {
      integral <- of_t %*% exp(likelihoods[[c]] - most) %*% t(of_u)
      density[, , , , c] <- density[, , , , c] + array(log(pmax(integral, 1e-300)), sizes[1:4])
    }
  }
  list(density = density, grids = grids)
}

# Quantiles of a density whose logarithm is a cubic spline.
quantiles <- function(values, log_density, shares) {
  fine <- seq(values[1], values[length(values)], length.out = 4001)
  density <- exp(spline(values, pmax(log_density, -40), xout = fine)$y)
  cumulated <- c(0, cumsum((density[-1] + density[-length(density)]) / 2))
  approx(cumulated, fine, shares * cumulated[length(cumulated)], ties = "ordered")$y
}

shares <- c(0.5, (1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2)

fit_group <- function(people) {
  priors <- priors_of(unlist(lapply(people, function(person) person$x)))
  tables <- lapply(people, table_of, priors, c(0.001, 0.02, 0.08))
  supports <- priors$supports
  for (round in 1:4) {
    posterior <- posterior_on(people, tables, priors, supports, COARSE)
    kept <- posterior$density > max(posterior$density) - 9
    for (i in 1:5) supports[i, ] <- around(posterior$grids[[i]], apply(kept, i, any))
  }
  posterior <- posterior_on(people, tables, priors, supports, FINE)
  mass <- exp(posterior$density - max(posterior$density))
  for (i in 1:5) mass <- sweep(mass, i, trapezoid(posterior$grids[[i]]), "*")
  found <- lapply(1:5, function(i) {
    log <- log(pmax(apply(mass, i, sum) / trapezoid(posterior$grids[[i]]), 1e-300))
    quantiles(posterior$grids[[i]], log - max(log), shares)
  })
  list("Weber fraction" = exp(found[[3]]), "PSE" = exp(found[[1]]), "lapse rate" = found[[5]],
       "spread of ln(Weber fraction)" = found[[4]], "spread of ln(PSE)" = found[[2]])
}

fit_one <- function(person) {
  priors <- priors_of(person$x)
  table <- table_of(person, priors, 0)
  density <- log_likelihood(person, table$t, table$u, 0)
  density <- exp(sweep(density + log_place_prior(priors, table$t), 2, table$u))
  along <- function(values, sums) quantiles(values, log(pmax(sums / max(sums), 1e-300)), shares)
  list("Weber fraction" = exp(along(table$u, colSums(density))), "PSE" = exp(along(table$t, rowSums(density))))
}

# --- mixed models -------------------------------------------------------------------------------------------------------

# Probit model with random intercepts and slopes: the GLMM of Moscatelli, Mezzetti and Lacquaniti (2012).
mixed_model <- function(trials) {
  trials$place <- log(trials$x) - mean(log(trials$x))
  model <- suppressMessages(lme4::glmer(response ~ place + (1 + place || participant), data = trials,
                                        family = binomial(link = "probit")))
  effects <- lme4::fixef(model)
  c("Weber fraction" = expm1(1 / effects[[2]]), "PSE" = exp(mean(log(trials$x)) - effects[[1]] / effects[[2]]))
}

# --- the program --------------------------------------------------------------------------------------------------------

arguments <- commandArgs(trailingOnly = TRUE)
own <- sub("^--file=", "", grep("^--file=", commandArgs(), value = TRUE))
paths <- arguments[!startsWith(arguments, "--")]
path <- if (length(paths) > 0) paths[1] else sub("-analysis\\.R$", ".csv", own)
if (!file.exists(path) || identical(path, own)) stop(path, ": no export of a study; give its path", call. = FALSE)
trials <- counted(read_trials(path))
for (block in unique(trials$block)) {
  of_block <- trials[trials$block == block, ]
  if (any(c(of_block$x, of_block$x_reference) <= 0)) {
    message(block, ": values at or below 0 have no Weber fraction; left out")
    next
  }
  people <- lapply(split(of_block, factor(of_block$participant, unique(of_block$participant))), function(person) {
    x <- sort(unique(person$x))
    list(x = x, k = sapply(x, function(at) sum(person$response[person$x == at])),
         n = sapply(x, function(at) sum(person$x == at)))
  })
  cat(sprintf("%s: %d participant%s, %d answers, reference %g\n", block, length(people), if (length(people) == 1) "" else "s", nrow(of_block),
              of_block$x_reference[1]))
  fit <- if (length(people) > 1) fit_group(people) else fit_one(people[[1]])
  for (what in names(fit)) {
    cat(sprintf("  %-30s %8.4g   %.4g to %.4g\n", what, fit[[what]][1], fit[[what]][2], fit[[what]][3]))
  }
  if (!("--no-glmm" %in% arguments) && length(people) > 1) {
    if (requireNamespace("lme4", quietly = TRUE)) {
      model <- mixed_model(of_block)
      cat(sprintf("  mixed model (probit, lme4)     Weber fraction %.4g, PSE %.4g\n", model[[1]], model[[2]]))
    } else {
      message("lme4 is not installed: no mixed model")
    }
  }
}
