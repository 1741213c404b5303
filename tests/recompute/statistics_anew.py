"""Medians, intervals and bounds as docs/measuring.md defines them."""
import math


def median(values):
    v, half = sorted(values), len(values) // 2
    return v[half] if len(v) % 2 else 0.5 * (v[half - 1] + v[half])


def interval(values):
    """(low, high, probability): from the k-th least to the k-th largest; (None, None, 0) where no k reaches 95 %."""
    v, n, best = sorted(values), len(values), None
    for k in range(1, n // 2 + 1):
        coverage = 1 - 2 * sum(math.comb(n, i) for i in range(k)) / 2**n
        if coverage >= 0.95:
            best = k, coverage
    return (v[best[0] - 1], v[n - best[0]], best[1]) if best else (None, None, 0.0)


def ratio(a, b):
    """Median of the ratios within a round, and its interval."""
    of = [x / y for x, y in zip(a, b) if x > 0 and y > 0]
    return median(of), interval(of)


def _beta_part(a, b, x):
    """The regularised incomplete beta function, by Lentz's continued fraction."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    if x > (a + 1) / (a + b + 2):
        return 1 - _beta_part(b, a, 1 - x)
    c, d, tiny = 1.0, 1 - (a + b) * x / (a + 1), 1e-300
    d = 1 / (d if abs(d) > tiny else tiny)
    f = d
    for m in range(1, 500):
        for term in (m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d, c = 1 + term * d, 1 + term / c
            d, c = 1 / (d if abs(d) > tiny else tiny), c if abs(c) > tiny else tiny
            f *= c * d
        if abs(c * d - 1) < 1e-15:
            break
    return f * math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a


def _where(rises, low, high):
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if rises(middle) else (middle, high)
    return 0.5 * (low + high)


def upper_share(wrong, of):
    """Clopper and Pearson's one-sided 95 % bound of a share."""
    return 1.0 if of == 0 or wrong >= of else _where(lambda p: _beta_part(wrong + 1, of - wrong, p) >= 0.95, 0.0, 1.0)


def student_t(degrees, below=0.975):
    """The value that Student's t with so many degrees of freedom stays below with this probability."""
    return _where(lambda t: 1 - 0.5 * _beta_part(degrees / 2, 0.5, degrees / (degrees + t * t)) >= below, 0.0, 1000.0)


def student_bound(values):
    """The one-sided 95 % prediction bound of one more value: of logarithms where all values are above 0."""
    logarithms = min(values) > 0
    v, n = [math.log(x) if logarithms else x for x in values], len(values)
    mean = sum(v) / n
    spread = math.sqrt(sum((x - mean) ** 2 for x in v) / (n - 1))
    bound = mean + student_t(n - 1, 0.95) * spread * math.sqrt(1 + 1 / n)
    return math.exp(bound) if logarithms else bound
